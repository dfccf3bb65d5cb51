"""Defines where a drive begins and ends on a road.

Source of the distances from the ends of the road: the simulations of the RoadGPT thesis and of the SBFT
competition.
"""

START = 2.5  # m along the road: station of the car's centre of gravity at the start
GOAL = 8.0  # m from the end of the left edge of the lane; a car that comes this close has arrived
LEAST = START + GOAL  # m; on a shorter road a car has arrived before it sets off
