"""Surveys people: makes a questionnaire from runs, serves it, and analyses the answers.

    SURVEY.toml or a study --new--> a folder --serve--> answers.sqlite --analyse--> report, tables, figures

plan, sampling    select the roads: ``read_plan`` reads SURVEY.toml, ``plan_from_runs`` selects at random
item_criteria     finds the criteria by which a road is rated, and computes scores for these criteria
build, media      make the survey's folder: plots, films, 3-D views, ``survey.json``
survey, questions define the texts, roads and questions that raters see
serving           makes the links and runs the server until Ctrl-C; needs the extra ``survey``
server, limits    limit connections and requests
app, pages        the Starlette application, and its Jinja2 pages from ``templates``
store, answers    keep the answers on disk, and convert them to table rows
synthetic         simulates raters, to try out the analysis
analysis, tally   analyse the answers; ``report_blocks`` and ``rating_charts`` make tables and figures

Import each function from its own module, so that serving does not load the modules that make plots.
"""
