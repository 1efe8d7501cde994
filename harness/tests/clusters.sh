#!/bin/sh
# The scripts of docs/clusters.md, as they stand there, on a small sweep: the cells are those of one process. As root, a
# Slurm of one node is begun where slurm-wlm and munge are installed; without it, array tasks run one after the other, and a
# stand-in for srun begins ranks by mpirun. Usage: clusters.sh PROGRAM SOURCE_ROOT MPIRUN (empty: built without MPI). Exit
# status 1 where a script fails, 77 where a tool is missing.
set -eu
program=$(readlink -f "$1") root=$2 mpirun=$3 skipped=0
folder=$(mktemp -d)
# What Slurm began ends, and writes its last files, before they are removed.
finish()
{
    for pid in "$folder"/*.pid; do
        [ ! -f "$pid" ] || kill "$(cat "$pid")" || :
    done
    for wait in 1 2 3 4 5 6 7 8 9 10; do
        ! rm -rf "$folder" 2>/dev/null || break
        sleep 1
    done
}
trap finish EXIT
cd "$folder"
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
export program mpirun

# The program on a scene of its own.
cat >sasbench <<'END'
#!/bin/sh
case $1 in
    sweep) exec "$program" "$@" study/quick -a bp_nearest -a bp_zeropad:factor=4 ;;
    *) exec "$program" "$@" ;;
esac
END
mkdir bin
cat >bin/srun <<'END'
#!/bin/sh
while case $1 in --*) ;; *) false ;; esac; do shift; done
exec "$mpirun" -n "$SLURM_NTASKS" "$@"
END
chmod +x sasbench bin/srun

# Slurm of this machine alone, at ports of its own; false where it does not start.
slurm_begin()
{
    [ "$(id -u)" -eq 0 ] && command -v slurmctld slurmd munged >/dev/null || return 1
    host=$(hostname -s)
    cat >slurm.conf <<END
ClusterName=one
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=46817
SlurmdPort=46818
SlurmUser=root
AuthInfo=socket=$folder/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/controller.pid
SlurmdPidFile=$folder/node.pid
SlurmctldLogFile=$folder/controller.log
SlurmdLogFile=$folder/node.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
NodeName=$host NodeAddr=127.0.0.1 CPUs=4
PartitionName=all Nodes=$host Default=YES
END
    export SLURM_CONF=$folder/slurm.conf
    chmod 755 .
    (umask 077 && head -c 1024 /dev/urandom >key)
    munged --force --socket="$folder/munge" --key-file="$folder/key" --pid-file="$folder/munge.pid" \
        --log-file="$folder/munge.log" --seed-file="$folder/seed" && slurmctld && slurmd || return 1
    for second in 1 2 3 4 5 6 7 8 9 10; do
        sleep 1
        ! sinfo -h -o %T | grep -q idle || return 0
    done
    return 1
}

# batch SCRIPT NAME=VALUE ...: by Slurm, or with the variables that it would set.
batch()
{
    job=$1
    shift
    if [ -n "$slurm" ]; then
        sbatch --wait "$job" >log 2>&1 || { cat log slurm-*.out; exit 1; }
    else
        env "$@" sh -e "$job" >log 2>&1 || { cat log; exit 1; }
    fi
}

slurm=yes
slurm_begin >slurm.log 2>&1 || { slurm='' PATH=$folder/bin:$PATH; echo "no Slurm that starts: a stand-in for srun"; }

cells() { grep -v '^#' "$1/measurements.csv" | cut -d, -f1-4 | sort; }

# script NUMBER TEXT TOOL: take the block of that number, which has the text; false where the tool is missing.
script()
{
    awk -v wanted="$1" '/^```sh$/ { n++; inside = 1; next } /^```$/ { inside = 0 } inside && n == wanted' \
        "$root/docs/clusters.md" >script
    grep -q "$2" script || { echo "script $1 of docs/clusters.md is without $2"; exit 1; }
    rm -rf parts results
    [ -n "$(command -v "$3")" ] || { echo "skipped: $2, there is no $3"; skipped=77; return 1; }
}

check()
{
    cells results/sweep >found
    cmp -s wanted found || { echo "script $1: other cells than one process has"; diff wanted found; exit 1; }
    echo "script $1: $(wc -l <found) rows"
}

./sasbench sweep --threads 1 -o whole >/dev/null
cells whole >wanted

if script 1 parallel parallel; then
    sh -e script >log 2>&1 || { cat log; exit 1; }
    check 1
fi
if script 2 SBATCH sh; then
    for task in ${slurm:-1 2 3 4}; do
        batch script SLURM_CPUS_PER_TASK=1 SLURM_ARRAY_TASK_ID="$task"
    done
    ./sasbench merge parts/* -o results/sweep >/dev/null
    check 2
fi
if script 3 'mpirun -n' "${mpirun:-mpirun that this build has}"; then
    PATH=$(dirname "$mpirun"):$PATH sh -e script >log 2>&1 || { cat log; exit 1; }
    check 3
fi
if script 4 srun "${mpirun:-mpirun that this build has}"; then
    batch script SLURM_CPUS_PER_TASK=1 SLURM_NTASKS=2
    check 4
fi
exit $skipped
