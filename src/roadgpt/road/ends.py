"""Where a drive begins and ends on a road.

Source: RoadGPT and the SBFT competition, whose simulations both start and stop there.
"""

START = 2.5  # m along the road where the car's centre of gravity is put
GOAL = 8.0  # m from the end of the road; a car that comes so near has arrived
LEAST = START + GOAL  # m; on a shorter road a car has arrived before it sets off
