"""Pages for people: one a run, one a campaign, one over all; each a single HTML file, no network."""
