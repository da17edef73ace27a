"""Which effect: the catalogue's columns, full-rate statistics, random processes, shapes of no catalogue."""
