#!/usr/bin/env bash
# slurm.sh [PROGRAM]: a sweep as an array job on a Slurm of one node that is started here and ended after. Tasks run out of
# time, one is requeued by hand, the node is lost: the table must be that of a run without Slurm, byte by byte. As root,
# with the packages slurm-wlm, munge and bc; some minutes. CASES=N: N cases, 100,000 unless it is given. TABLE=1 writes
# docs/measured/slurm.txt.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
withy=$(realpath "${1:-build/release/bin/withy}")
for tool in slurmctld slurmd munged sbatch bc; do
  command -v "$tool" >/dev/null || PATH=$PATH:/usr/sbin
  command -v "$tool" >/dev/null || { echo "$tool is missing: apt-get install slurm-wlm munge bc" >&2; exit 3; }
done

work=$(mktemp -d /tmp/withy-slurm.XXXXXX)
started=()
finish() {
  local id
  for id in "${started[@]}"; do kill "$id" 2>/dev/null || true; done
  wait  # they write where is to be cleared
  [ -n "${KEEP:-}" ] || rm -rf "$work"
}
trap finish EXIT

node=$(hostname -s)
mkdir -p "$work"/{munge,state,spool,log}
chmod 755 "$work" && chmod 700 "$work/munge"
dd if=/dev/urandom of="$work/munge/key" bs=128 count=1 status=none && chmod 400 "$work/munge/key"
munged --force --foreground --key-file="$work/munge/key" --socket="$work/munge/socket" --pid-file="$work/munge/pid" \
  --log-file="$work/munge/log" --seed-file="$work/munge/seed" >"$work/log/munged" 2>&1 &
started+=($!)
cat >"$work/slurm.conf" <<CONF
ClusterName=withy
SlurmctldHost=$node(127.0.0.1)
SlurmUser=root
SlurmctldPort=16817
SlurmdPort=16818
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
CredType=cred/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/log/slurmctld
SlurmdLogFile=$work/log/slurmd
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,batch_sched_delay=1
MinJobAge=600
KillWait=5
ReturnToService=2
MpiDefault=none
NodeName=$node NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$node Default=YES MaxTime=INFINITE State=UP
CONF
printf 'CgroupPlugin=cgroup/v1\n' >"$work/cgroup.conf"
export SLURM_CONF=$work/slurm.conf
sleep 1
slurmctld -D >"$work/log/slurmctld.out" 2>&1 &
started+=($!)
start_node() { slurmd -D >>"$work/log/slurmd.out" 2>&1 & node_id=$!; started+=("$node_id"); }
start_node
for _ in $(seq 60); do [ "$(sinfo -h -o %T 2>/dev/null)" = idle ] && break; sleep 0.5; done
[ "$(sinfo -h -o %T)" = idle ] || { cat "$work"/log/*; echo "the node does not come up" >&2; exit 3; }

# A minute or more of work in each task, of which Slurm lets it have less than that at a time.
cases=${CASES:-100000}
cat >"$work/plan.yaml" <<PLAN
format: withy-sweep/1
scene: $PWD/scenes/driven-arm.yaml
set: {integrator: {name: rk4, step: 0.009}}
vary: {bodies.link1.mass_per_length: {normal: {mean: 1.33937, deviation: 0.02}}}
cases: $cases
evaluation: in-lanes
keep: {final: [shoulder, elbow], peak: [link1.tip.deflection_y]}
PLAN
"$withy" sweep run "$work/plan.yaml" --out "$work/whole"
began=$(date +%s)
submitted=$("$withy" sweep submit "$work/plan.yaml" --out "$work/store" --slurm --tasks 2 --time 00:01:00 \
  --sbatch=--signal=B:USR1@10 --json)
echo "$submitted"
array=$(sed -n 's/.*"array_job": "\([0-9]*\)".*/\1/p' <<<"$submitted")
collect=$(sed -n 's/.*"collect_job": "\([0-9]*\)".*/\1/p' <<<"$submitted")
sleep 6
scontrol requeue "${array}_1"  # as an administrator does
sleep 6
# The node is lost, with all that runs on it.
lost=$(scontrol listpids | awk 'NR > 1 && $1 > 1 { print $1 }')
kill -9 "$node_id"
# shellcheck disable=SC2086 # several ids
kill -9 $lost || true
scontrol update nodename="$node" state=down reason=lost
sleep 1
start_node
sleep 1
scontrol update nodename="$node" state=resume 2>/dev/null || true  # it may have come back by itself
restarts() { scontrol show job "$array" | sed -n 's/.*Restarts=\([0-9]*\).*/\1/p' | paste -sd+ | bc; }
most=0 state=
for _ in $(seq "${PATIENCE:-1500}"); do
  now=$(restarts 2>/dev/null || echo 0)
  [ "${now:-0}" -le "$most" ] || most=$now
  state=$(scontrol show job "$collect" | sed -n 's/.*JobState=\([A-Z_]*\).*/\1/p')
  case $state in
    COMPLETED) break ;;
    FAILED | CANCELLED | TIMEOUT) cat "$work"/store/slurm/*.log; exit 1 ;;
  esac
  sleep 1
done
wall=$(($(date +%s) - began))
cat "$work"/store/slurm/*.log
[ "$state" = COMPLETED ] || { squeue; echo "the job that collects is $state after $wall s" >&2; exit 1; }
cmp "$work/whole/table.csv" "$work/store/table.csv"
[ "$most" -ge 3 ] || { echo "tasks were queued again $most times, not as often as they were ended" >&2; exit 1; }
echo "tasks were queued again $most times; the table is the same, byte by byte"
[ -n "${TABLE:-}" ] || exit 0
# shellcheck source=scripts/measured.sh
. scripts/measured.sh
{
  printf '\t\n'
  printf '%s\t%s\n' cases "$cases" 'tasks, each with a core' 2 'times that tasks were queued again' "$most" 'nodes lost' 1 \
    "wall time, with Slurm's own delays" "$wall s" 'tables the same, byte by byte' yes
} | record_table slurm "scripts/slurm.sh"
