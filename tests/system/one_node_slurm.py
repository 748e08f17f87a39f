"""A Slurm of one node on this machine, on loopback, with everything in one folder. Needs root."""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import threading
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "sinfo", "scontrol")
PACKAGES = ("slurm-wlm", "munge")

SLURM_CONF = """\
ClusterName=parkade
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket,cred_expire=5
SlurmUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
ReturnToService=2
MpiDefault=none
JobCompType=jobcomp/none
AccountingStorageType=accounting_storage/none
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
SlurmctldTimeout=10
SlurmdTimeout=10
KillWait=4
MinJobAge=10
SchedulerParameters=sched_interval=1,batch_sched_delay=0
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory=4000 State=UNKNOWN
PartitionName=maps Nodes={host} Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
"""

# Slurmd of 22.05 starts only with a cgroup plugin that finds its hierarchy.
CGROUP_CONF = """\
CgroupAutomount=no
CgroupPlugin=cgroup/{version}
ConstrainCores=no
ConstrainRAMSpace=no
"""


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def install():
    """Why there can be no Slurm here; nothing where there can."""
    if os.geteuid() != 0:
        return "needs root"
    missing = [program for program in PROGRAMS if shutil.which(program) is None]
    if missing:
        environment = dict(os.environ, DEBIAN_FRONTEND="noninteractive")
        subprocess.run(["apt-get", "update", "-q"], check=False, capture_output=True, timeout=120)
        subprocess.run(["apt-get", "install", "-y", "-q", "--no-install-recommends", *PACKAGES], check=False,
                       capture_output=True, env=environment, timeout=600)
        missing = [program for program in PROGRAMS if shutil.which(program) is None]
    return f"there is no {', '.join(missing)} and it cannot be installed" if missing else None


class OneNodeSlurm:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.daemons = {}
        self.is_over = threading.Event()
        self.host = socket.gethostname().split(".")[0]
        for name in ("state", "spool", "munge"):
            (self.folder / name).mkdir(mode=0o700, parents=True)
        (self.folder / "munge/key").write_bytes(os.urandom(1024))
        (self.folder / "munge/key").chmod(0o400)
        version = "v1" if pathlib.Path("/sys/fs/cgroup/freezer").exists() else "v2"
        (self.folder / "cgroup.conf").write_text(CGROUP_CONF.format(version=version))
        (self.folder / "slurm.conf").write_text(SLURM_CONF.format(
            host=self.host, folder=self.folder, controller_port=free_port(), node_port=free_port(),
            cpus=os.cpu_count()))
        self.environment = dict(os.environ, SLURM_CONF=str(self.folder / "slurm.conf"))

    def start(self):
        """False where it does not come up, and then the daemons' words are in the folder."""
        munge = self.folder / "munge"
        self.spawn("munged", "--foreground", "--force", f"--socket={munge}/socket", f"--key-file={munge}/key",
                   f"--pid-file={munge}/pid", f"--seed-file={munge}/seed", f"--log-file={munge}/log")
        for _ in range(100):
            if (munge / "socket").exists():
                break
            time.sleep(0.05)
        self.start_controller()
        self.start_node()
        threading.Thread(target=self.operate, daemon=True).start()
        return self.wait_for_node()

    def operate(self):
        """Does what Slurm leaves to its operator: a controller that lost its latest state gives a number again, and
        drains the node that still ends the first job of this number."""
        while not self.is_over.wait(2):
            if "Duplicate jobid" in self.ask("scontrol", "show", "node", self.host):
                self.ask("scontrol", "update", f"NodeName={self.host}", "State=RESUME")

    def spawn(self, name, *arguments):
        with open(self.folder / f"{name}.out", "ab") as log:
            self.daemons[name] = subprocess.Popen([name, *arguments], env=self.environment, stdout=log, stderr=log)

    def start_controller(self):
        self.spawn("slurmctld", "-D")

    def start_node(self):
        self.spawn("slurmd", "-D")

    def wait_for_node(self):
        for _ in range(300):
            if self.ask("sinfo", "-h", "-o", "%T").strip() in ("idle", "mixed", "allocated"):
                return True
            time.sleep(0.1)
        return False

    def ask(self, *command):
        return subprocess.run(command, check=False, capture_output=True, text=True, env=self.environment,
                              timeout=60).stdout

    def kill(self, name):
        self.daemons[name].kill()
        self.daemons[name].wait()

    def steps(self):
        """Processes that hold jobs on the node."""
        found = []
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                ours = f"SLURM_CONF={self.folder}/slurm.conf".encode() in (process / "environ").read_bytes()
                if ours and (process / "cmdline").read_bytes().startswith(b"slurmstepd"):
                    found.append(int(process.name))
            except OSError:
                pass
        return found

    def lose_node(self, others):
        """What a machine leaves that loses its power, and that the controller hears of."""
        for pid in [self.daemons["slurmd"].pid, *self.steps(), *others]:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        self.daemons["slurmd"].wait()
        self.ask("scontrol", "update", f"nodename={self.host}", "state=down", "reason=test")

    def return_node(self):
        self.start_node()
        time.sleep(0.5)
        self.ask("scontrol", "update", f"nodename={self.host}", "state=resume")
        return self.wait_for_node()

    def stop(self):
        self.ask("scancel", "--user=root")
        self.is_over.set()
        for name in ("slurmd", "slurmctld", "munged"):
            if name in self.daemons:
                self.kill(name)
        for pid in self.steps():
            os.kill(pid, signal.SIGKILL)
