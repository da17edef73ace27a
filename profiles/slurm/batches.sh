#!/bin/sh
# Many small runs on a Slurm cluster: the runs in N batches, the plain command on each in a Slurm job of its own, and
# after them the plain command once more, for what spans runs. From the folder of the Snakefile:
#
#     profiles/slurm/batches.sh N [ARGUMENTS OF SNAKEMAKE]
#
# What sbatch is to ask for stands in its own variables (SBATCH_ACCOUNT, SBATCH_PARTITION, SBATCH_TIMELIMIT); CPUS is
# the number of processors a batch gets (4), MEM its memory (2G). Prints the Slurm job to wait for.
set -eu

case ${1:-} in
batch)
    shift
    export FOGREDUCE_BATCH="$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT"
    # No two batches share a file, so they need no lock, which the first to end would take away from the others.
    exec snakemake runs --nolock --cores "$SLURM_CPUS_PER_TASK" "$@"
    ;;
rest)
    shift
    exec snakemake --cores "$SLURM_CPUS_PER_TASK" "$@"
    ;;
'' | *[!0-9]* | 0*)
    echo "batches.sh: found '${1:-}' for the number of batches; expected a whole number from 1" >&2
    exit 2
    ;;
esac

batches=$1
shift
logs=.snakemake/slurm_logs
mkdir -p "$logs"
submit() { sbatch --parsable --cpus-per-task="${CPUS:-4}" --mem="${MEM:-2G}" "$@"; }
first=$(submit --job-name=fogreduce --array="1-$batches" --output="$logs/batch-%a.log" "$0" batch "$@")
# afterany: a run that fails keeps none of the others out of the tables.
submit --job-name=fogreduce-rest --dependency="afterany:$first" --output="$logs/rest.log" "$0" rest "$@"
