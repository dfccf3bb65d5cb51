"""Surveys people: makes a questionnaire from runs, serves it, and analyses the answers.

    SURVEY.toml or a study --new--> a folder --serve--> answers.sqlite --analyse--> report, tables, figures

plan, sampling    say which roads are rated: ``read_plan`` reads a file, ``plan_from_runs`` draws them
item_criteria     finds the criteria in which a road is rated, and measures the road in them
build, media      make the survey's folder: plots, films, 3-D views, ``survey.json``
survey, questions define the survey as raters see it
serving           makes the links and runs the server until Ctrl-C; needs the extra ``survey``
server, limits    limit connections and requests
app, pages        the Starlette application, and its Jinja2 pages from ``templates``
store, answers    keep the answers on disk, and turn them into rows
synthetic         makes up raters, to try out the analysis
analysis, tally   analyse the answers; ``report_blocks`` and ``rating_charts`` make tables and figures

Import each function from its own module, so that serving does not load the modules that draw.
"""
