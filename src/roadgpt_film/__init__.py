"""Films of drives, from behind the car or from its hood: ``film.write`` makes one, ``roadgpt film`` many."""
