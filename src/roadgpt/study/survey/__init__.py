"""Surveys people: makes the questionnaire from runs, serves it, and analyses the answers.

    SURVEY.toml or a study --new--> a folder --serve--> answers.sqlite --analyse--> report, tables, figures

plan, sampling    which roads: ``read_plan`` reads a file, ``plan_from_runs`` draws them from folders of runs
build             ``make_survey``: plots, films, 3-D views, survey.json
serving           ``serve``: links, and the server until Ctrl-C; needs the extra ``survey``
server, limits    uvicorn, with limits on connections and requests
app, pages        the Starlette application, and its Jinja2 pages from ``templates``
store, answers    the answers on disk, and as rows
synthetic         made-up raters, to try out the analysis
analysis          ``analyse``: statistics, figures, report

Import each function from its own module, so that serving need not load the modules that draw.
"""
