"""What somebody who knows the truth could see at best: the yardstick beside every score."""
