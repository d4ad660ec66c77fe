#!/usr/bin/env bash
# One share of a picture's samples for each task of a Slurm array, merged when all are done:
#
#   job=$(sbatch --parsable --array=1-8 farm/slurm.sh scene.xml picture.exr 512)
#   sbatch --dependency=afterok:"$job" --wrap 'velour merge picture.part*.exr -o picture.exr --samples 0..512'
#
# A task that is put back goes on from what it has kept; the bytes it writes are the same.
#SBATCH --job-name=velour
#SBATCH --requeue
#SBATCH --open-mode=append
set -euo pipefail
scene=$1 out=$2 samples=$3
# A fourth argument tells into how many shares it was cut, when only some of them are run again (--array=3).
task=$SLURM_ARRAY_TASK_ID tasks=${4:-$SLURM_ARRAY_TASK_COUNT}
part=${out%.exr}.part$(printf %04d "$task").exr
resume=()
if [ -s "$part" ]; then resume=(--resume "$part"); fi
# In place of this shell, so that the signals of the engine reach it.
exec "${VELOUR:-velour}" render "$scene" -o "$part" --spp "$samples" --share "$task/$tasks" \
    --threads "${SLURM_CPUS_PER_TASK:-0}" ${resume[@]+"${resume[@]}"}
