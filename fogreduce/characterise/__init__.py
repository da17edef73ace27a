"""What a unit is: the terms of a test report, each with its uncertainty."""
