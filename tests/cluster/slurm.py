# A SLURM of one node on loopback, with its authentication, for as long as a test wants it.
import os
import pathlib
import pwd
import re
import shutil
import socket
import subprocess
import tempfile
import time

PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue", "scancel"]

CONFIGURATION = """
ClusterName=isoline
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
SchedulerParameters=sched_interval=1,bf_interval=1,batch_sched_delay=0
MpiDefault=none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
JobAcctGatherType=jobacct_gather/none
ReturnToService=2
KillWait=10
MaxArraySize=9
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=main Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


PAGE = pathlib.Path(__file__).parents[2] / "docs" / "on-a-cluster.md"


def block(fence):
    """The lines of the one block with this fence in the page on clusters."""
    found = re.findall(rf"^```{fence}\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.M | re.S)
    assert len(found) == 1, f"{len(found)} blocks {fence}"
    return found[0].splitlines()


def write_scripts(folder):
    for name in ["shard.sh", "merge.sh"]:
        text = "\n".join(block(f"shell {name}")) + "\n"
        pathlib.Path(folder, name).write_text(text, encoding="utf-8")


def programs():
    """The path of each program, None where it is not installed."""
    path = os.environ.get("PATH", "") + ":/usr/sbin:/sbin"
    return {name: shutil.which(name, path=path) for name in PROGRAMS}


def what_is_missing():
    """A sentence, or nothing where a SLURM can be started here."""
    missing = [name for name, path in programs().items() if path is None]
    if missing:
        return ", ".join(missing) + " not installed (Debian's packages slurm-wlm and munge)"
    return None


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class Slurm:
    """Started by `with`, and stopped after it, however that ends."""

    def __enter__(self):
        self.folder = tempfile.mkdtemp(prefix="isoline-slurm-")
        os.chmod(self.folder, 0o755)  # munge's socket must be within everyone's reach
        self.host = socket.gethostname().split(".")[0]
        self.found = programs()
        self.started = []
        for part in ["state", "spool"]:
            os.mkdir(f"{self.folder}/{part}")
        with open(f"{self.folder}/slurm.conf", "w", encoding="utf-8") as out:
            out.write(CONFIGURATION.format(
                host=self.host, user=pwd.getpwuid(os.getuid()).pw_name, folder=self.folder,
                controller_port=free_port(), node_port=free_port()))
        self.environment = dict(os.environ, SLURM_CONF=f"{self.folder}/slurm.conf")
        try:
            self.start_all()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for process in reversed(self.started):
            process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def start_all(self):
        folder = self.folder
        key = f"{folder}/munge.key"
        with open(os.open(key, os.O_CREAT | os.O_WRONLY, 0o600), "wb") as out:
            out.write(os.urandom(128))
        self.start("munged", "--foreground", f"--key-file={key}", f"--socket={folder}/munge.socket",
                   f"--pid-file={folder}/munge.pid", f"--log-file={folder}/munge.log",
                   f"--seed-file={folder}/munge.seed")
        self.wait_for(lambda: os.path.exists(f"{folder}/munge.socket"), "munged")
        self.start("slurmctld", "-D", "-i")
        self.start("slurmd", "-D", "-N", self.host)
        self.wait_for(lambda: " idle" in self.tell("sinfo", "-h", "-o", " %T"), "the node")

    def start(self, name, *arguments):
        with open(f"{self.folder}/{name}.out", "wb") as log:
            self.started.append(subprocess.Popen([self.found[name], *arguments], stdout=log,
                                                 stderr=log, env=self.environment))

    def tell(self, *command):
        """What a command prints; nothing where it fails."""
        run = subprocess.run(command, env=self.environment, capture_output=True, text=True,
                             check=False)
        return run.stdout if run.returncode == 0 else ""

    def wait_for(self, holds, what, seconds=120):
        end = time.monotonic() + seconds
        while not holds():
            ended = [process.args[0] for process in self.started if process.poll() is not None]
            if ended:
                raise AssertionError(f"{ended} ended while waiting for {what}\n{self.logs()}")
            if time.monotonic() > end:
                raise AssertionError(f"waited {seconds} s for {what}\n{self.logs()}")
            time.sleep(0.2)

    def logs(self):
        text = self.tell("squeue", "-a")
        for name in ["munged.out", "slurmctld.log", "slurmd.log"]:
            path = f"{self.folder}/{name}"
            if os.path.exists(path):
                with open(path, encoding="utf-8", errors="replace") as lines:
                    text += f"--- {name}\n" + "".join(lines.readlines()[-40:])
        return text

    def jobs(self, state=None):
        """The tasks that are in the queue, as "JOB_TASK"; of a state, or all."""
        lines = self.tell("squeue", "-h", "-r", "-o", "%i %T").splitlines()
        return [line.split()[0] for line in lines if state is None or line.split()[1] == state]

    def wait_until_empty(self, seconds=600):
        self.wait_for(lambda: not self.jobs(), "the queue to be empty", seconds)
