"""Studies: the thesis' evaluation on any designer, and people's own. Makes a Study. Verb: ``compare``.

``thesis``      three descriptions, many roads each: how many are valid, how many drives leave the lane
``alignment``   every promise of a description, measured on the final geometry, criterion by criterion
``similarity``  how alike two roads are: turns, their order and sides, length, incline, shape
``statistics``  the tests and intervals that all of these, and the survey of people, are judged by
"""
