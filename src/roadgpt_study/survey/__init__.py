"""Surveys people: makes a questionnaire from runs, serves it, and analyses the answers.

    SURVEY.toml or a study --new--> a folder --serve--> answers.sqlite --analyse--> report, tables, figures

plan              selects the roads: ``read_plan`` reads SURVEY.toml, ``plan_from_runs`` selects at random
build             makes the survey's folder: plots, films, 3-D views, ``survey.json``
survey            defines the texts, roads and questions that raters see
serving           makes the links and runs the server until Ctrl-C; needs the extra ``survey``
server            listens, and limits connections
app               the Starlette application, which limits requests, with Jinja2 pages from ``templates``
store, answers    keep the answers on disk, convert them to table rows, and count ratings
analysis          analyses the answers of people or of simulated raters; ``rating_charts`` makes the figures

Import each function from its own module, so that serving does not load the modules that make plots.
"""
