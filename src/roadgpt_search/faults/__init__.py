"""Groups failures by fault, and analyses each fault: why it occurs, how often it recurs, and the simplest
road on which it occurs."""
