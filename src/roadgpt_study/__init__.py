"""Repeats the evaluation of RoadGPT's thesis: many roads from many descriptions, and surveys of people.

plan, execution   read prompts and define a study (descriptions, designers, number of roads); make its roads
study_report      writes the report of a study
survey            asks people to rate roads
"""
