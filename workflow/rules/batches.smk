"""`runs`: every run, without the tables over them; or one batch of several, as profiles/slurm/batches.sh asks."""

BATCH, _, BATCHES = ASKED.partition("/")
if not (BATCH.isdecimal() and BATCHES.isdecimal() and 1 <= int(BATCH) <= int(BATCHES)):
    stop(f"FOGREDUCE_BATCH: found {ASKED!r}; expected a batch of several, such as 2/20")


rule runs:
    input:
        expand(run_file("outputs.json"), zip, **run_wildcards())[
            int(BATCH) - 1 :: int(BATCHES)
        ],
