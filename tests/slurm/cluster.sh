# A Slurm of two nodes on this machine, for a test: source it, then start_cluster FOLDER ... stop_cluster.
# Needs root (munged runs as user munge) and the packages slurm-wlm and munge. Ends only what it started.

cluster_pids=()

have_slurm() { command -v slurmctld slurmd sbatch munged >/dev/null && [ "$(id -u)" -eq 0 ]; }

# start_node NAME
start_node() {
  slurmd -D -N "$1" >"$cluster/$1.out" 2>&1 &
  eval "pid_of_$1=$!"
  cluster_pids+=($!)
}

start_cluster() {
  cluster=$1
  mkdir -p "$cluster/state" "$cluster/n1" "$cluster/n2" "$cluster/munge"
  # A munge of our own, beside one that may be running: key, socket and logs lie in the folder.
  chown -R munge:munge "$cluster/munge"
  chmod 755 "$cluster" "$cluster/munge"
  head -c 1024 /dev/urandom >"$cluster/munge/key"
  chown munge:munge "$cluster/munge/key" && chmod 400 "$cluster/munge/key"
  setpriv --reuid=munge --regid=munge --clear-groups munged --foreground --force --key-file="$cluster/munge/key" \
    --socket="$cluster/munge/socket" --log-file="$cluster/munge/log" --pid-file="$cluster/munge/pid" \
    --seed-file="$cluster/munge/seed" >"$cluster/munged.out" 2>&1 &
  cluster_pids+=($!)
  local port=$((20000 + $$ % 20000))
  cat >"$cluster/slurm.conf" <<CONF
ClusterName=isthmus
SlurmctldHost=localhost
SlurmctldPort=$port
AuthType=auth/munge
AuthInfo=socket=$cluster/munge/socket
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SlurmUser=root
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MaxArraySize=9
SlurmdTimeout=10
KillWait=2
SchedulerParameters=sched_interval=1,sched_min_interval=0,batch_sched_delay=0
StateSaveLocation=$cluster/state
SlurmdSpoolDir=$cluster/%n
SlurmctldLogFile=$cluster/slurmctld.log
SlurmdLogFile=$cluster/slurmd-%n.log
SlurmctldPidFile=$cluster/slurmctld.pid
SlurmdPidFile=$cluster/slurmd-%n.pid
NodeName=n1 NodeHostname=localhost NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1 RealMemory=1000
NodeName=n2 NodeHostname=localhost NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1 RealMemory=1000
PartitionName=main Nodes=n1,n2 Default=YES State=UP MaxTime=INFINITE
CONF
  export SLURM_CONF=$cluster/slurm.conf
  slurmctld -D >"$cluster/slurmctld.out" 2>&1 &
  cluster_pids+=($!)
  start_node n1
  start_node n2
  for _ in $(seq 120); do
    [ "$(sinfo --noheader --Node --format=%T 2>/dev/null | grep -c idle)" = 2 ] && return 0
    sleep 0.5
  done
  echo "the cluster did not come up:"
  tail -n 5 "$cluster"/*.out "$cluster"/*.log
  return 1
}

# tasks_on NAME: processes of jobs there. Two programs for all processes: a task may last a second only.
tasks_on() {
  grep -lzxF "SLURM_CONF=$cluster/slurm.conf" /proc/[0-9]*/environ 2>/dev/null |
    xargs -r grep -lzxF "SLURMD_NODENAME=$1" 2>/dev/null | cut -d/ -f3
  true
}

# kill_node NAME PID: its daemon, the keepers of its steps and what they run, as when a machine loses its power. Waits until
# there is something to lose.
kill_node() {
  local tasks keepers="" pid parent
  for _ in $(seq 600); do
    tasks=$(tasks_on "$1")
    [ -n "$tasks" ] && break
    sleep 0.1
  done
  kill -9 "$2"
  for pid in $tasks; do
    parent=$(awk '{print $4}' "/proc/$pid/stat" 2>/dev/null) || continue
    [ "$(cat "/proc/$parent/comm" 2>/dev/null)" = slurmstepd ] && keepers+=" $parent"
  done
  for pid in $keepers $tasks; do kill -9 "$pid" 2>/dev/null || true; done
  echo "killed node $1: its daemon, $(wc -w <<<"$keepers") steps, $(wc -w <<<"$tasks") processes"
  [ -n "$tasks" ]
}

stop_cluster() {
  scancel --user=root 2>/dev/null || true
  for pid in "${cluster_pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  for pid in "${cluster_pids[@]}"; do wait "$pid" 2>/dev/null || true; done
}
