"""A server that has imported everything and forks for each command: jobs need not start from cold.

`start` begins it beside a workflow, `serve` is what it does, `client` stands in for the command.
"""
