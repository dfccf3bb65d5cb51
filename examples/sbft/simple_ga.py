"""A generator for the SBFT tool competition: a small genetic algorithm over curvatures.

A road's fitness is the largest share of the car that was outside its lane.

    cd examples/sbft
    roadgpt compete sbft --module-name simple_ga --class-name SimpleGA --test-budget 200
"""

import math
import os
import random

from code_pipeline.tests_generation import RoadTestFactory
from curvature_walk import STEPS, TIGHTEST, road_of

POPULATION = 20
TOURNAMENT = 3
MUTATION = 0.2  # chance of each curvature
SPREAD = 0.02  # 1/m, standard deviation of a mutation
INVALID = -1.0  # fitness


class SimpleGA:
    """Keeps the fittest roads, and makes the next from them."""

    def __init__(self, executor=None, map_size=None):
        self.executor = executor
        self.map_size = map_size
        self.random = random.Random(int(os.environ.get("GENERATOR_SEED", "1")))

    def start(self):
        """Generation after generation, until the budget is over."""
        population = self.tried([self.walk() for _ in range(POPULATION)])
        while not self.executor.is_over():
            children = [self.child(population) for _ in range(POPULATION)]
            both = population + self.tried(children)
            population = sorted(both, key=lambda pair: pair[0], reverse=True)[:POPULATION]

    def tried(self, genomes):
        """(fitness, genome) of each that the budget allows; repeats of a road are tried again."""
        found = []
        for genome in genomes:
            if self.executor.is_over():
                break
            found.append((self.fitness(genome), genome))
        return found

    def fitness(self, genome):
        """Largest share of the car outside its lane, 0 to 1."""
        heading, *bends = genome
        test = RoadTestFactory.create_road_test(road_of(bends, heading, self.map_size))
        if not self.executor.validate_test(test)[0]:
            return INVALID
        _, _, records = self.executor.execute_test(test)
        return max((record.oob_percentage for record in records), default=INVALID)

    def walk(self):
        """A first genome: a heading, and curvatures that follow each other smoothly."""
        bends = [self.random.uniform(-TIGHTEST, TIGHTEST)]
        while len(bends) < STEPS:
            bends.append(self.limited(bends[-1] + self.random.uniform(-TIGHTEST, TIGHTEST) / 2))
        return [self.random.uniform(0, 2 * math.pi), *bends]

    def child(self, population):
        """One-point crossover of two that won their tournaments, mutated."""
        mother, father = self.winner(population), self.winner(population)
        cut = self.random.randrange(1, STEPS)
        heading, *bends = mother[:cut] + father[cut:]
        return [heading, *(self.mutated(bend) for bend in bends)]

    def winner(self, population):
        """The fittest of a few."""
        return max(self.random.choices(population, k=TOURNAMENT), key=lambda pair: pair[0])[1]

    def mutated(self, bend):
        """Another curvature, now and then."""
        return self.limited(self.random.gauss(bend, SPREAD)) if self.random.random() < MUTATION else bend

    @staticmethod
    def limited(bend):
        """A curvature that the competition allows."""
        return min(max(bend, -TIGHTEST), TIGHTEST)
