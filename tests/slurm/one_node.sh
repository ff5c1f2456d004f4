#!/bin/bash
# A Slurm cluster of this one machine, for the length of one command:
#   tests/slurm/one_node.sh COMMAND…
# Starts munged, slurmctld and slurmd (Debian: slurm-wlm, munge) with keys, sockets, ports and state of their own in a folder under TMPDIR,
# runs the command with SLURM_CONF set, and ends the three again. Leaves an installed Slurm alone. Exits 77, with the reason, where the
# cluster cannot be started; else with the command's own code.
set -u
for program in munged slurmctld slurmd sbatch sinfo; do
  command -v "$program" > /dev/null || { echo "skipped: $program is not installed (Debian: slurm-wlm, munge)" >&2; exit 77; }
done
folder=$(mktemp -d "${TMPDIR:-/tmp}/one_node.XXXXXX")
host=$(hostname -s) user=$(id -un) port=$((20000 + RANDOM % 20000)) children=()
finish() {
  for child in "${children[@]}"; do kill "$child" 2> /dev/null; done
  for child in "${children[@]}"; do wait "$child" 2> /dev/null; done
  rm -rf "$folder"
}
trap finish EXIT
give_up() {
  echo "skipped: $1" >&2
  tail -n 5 "$folder"/*.log >&2
  exit 77
}
mkdir "$folder/state" "$folder/spool"
chmod 755 "$folder"
(umask 077; head -c 1024 /dev/urandom > "$folder/munge.key")
munged --foreground --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" --pid-file="$folder/munged.pid" \
  --log-file="$folder/munged.log" --seed-file="$folder/munged.seed" > "$folder/munged.out.log" 2>&1 &
children+=($!)
cat > "$folder/slurm.conf" << END
ClusterName=one_node
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
SchedulerParameters=sched_interval=1,batch_sched_delay=1
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc)
PartitionName=all Nodes=$host Default=YES State=UP
END
export SLURM_CONF=$folder/slurm.conf
for _ in $(seq 100); do [ -S "$folder/munge.socket" ] && break; sleep 0.2; done
[ -S "$folder/munge.socket" ] || give_up "munged does not start"
slurmctld -D > "$folder/slurmctld.out.log" 2>&1 &
children+=($!)
slurmd -D -N "$host" > "$folder/slurmd.out.log" 2>&1 &
children+=($!)
for _ in $(seq 150); do
  [ "$(sinfo --noheader --format=%T 2> /dev/null)" = idle ] && break
  sleep 0.4
done
[ "$(sinfo --noheader --format=%T 2> /dev/null)" = idle ] || give_up "no node of the cluster became idle: $(sinfo 2>&1 | tail -n 1)"
"$@"
