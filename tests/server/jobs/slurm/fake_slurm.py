#!/usr/bin/env python3
"""sbatch, squeue and scancel for tests, by the name it is called by. Its folder holds the state:

    jobs/ID.json          what squeue shows of a job
    calls                 the words of every call, a line of JSON each
    COMMAND.mode          how COMMAND behaves; see below
    hold                  while this is there, jobs wait

sbatch starts the script at once, as a process of its own.
"""

import json
import os
import pathlib
import signal
import subprocess
import sys
import time

FOLDER = pathlib.Path(sys.argv[0]).parent
NAME = pathlib.Path(sys.argv[0]).name


def mode():
    file = FOLDER / f"{NAME}.mode"
    return file.read_text().strip() if file.exists() else "well"


def write(job, **changes):
    file = FOLDER / "jobs" / f"{job}.json"
    content = json.loads(file.read_text()) if file.exists() else {}
    content.update(changes)
    temporary = file.with_suffix(f".{os.getpid()}")
    temporary.write_text(json.dumps(content))
    temporary.rename(file)


def state(job):
    return json.loads((FOLDER / "jobs" / f"{job}.json").read_text())["job_state"]


def fail(sentence):
    print(f"{NAME}: error: {sentence}", file=sys.stderr)
    sys.exit(1)


def all_jobs():
    return [json.loads(file.read_text()) for file in (FOLDER / "jobs").glob("*.json")]


def waits_for(array):
    """Whether an element of the array has yet to end."""
    return array and any(job["job_state"] in ("PENDING", "RUNNING") for job in all_jobs()
                         if array in (str(job.get("array_job_id", 0)), str(job["job_id"])))


def run(job, command, folder, array=None, after=None):
    """The job's own process, which outlives sbatch."""
    if os.fork() != 0:
        return
    os.setsid()
    quiet = os.open("/dev/null", os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(quiet, stream)
    while (FOLDER / "hold").exists() or waits_for(after):
        if state(job) != "PENDING":
            os._exit(0)
        time.sleep(0.02)
    if state(job) != "PENDING":
        os._exit(0)
    words = {"SLURM_JOB_ID": str(job), "PATH": os.environ["PATH"]}
    if array is not None:
        words["SLURM_ARRAY_TASK_ID"] = str(array)
    with open(pathlib.Path(folder) / "log.txt", "ab") as log:
        process = subprocess.Popen(command, cwd=folder, stdout=log, stderr=log, start_new_session=True, env=words)
    write(job, job_state="RUNNING", state_reason="None", pid=process.pid)
    status = process.wait()
    if state(job) == "RUNNING":
        code = -status if status < 0 else status << 8
        write(job, job_state="COMPLETED" if status == 0 else "FAILED", exit_code=code)
    os._exit(0)


def sbatch():
    if mode() == "refuse":
        fail("Unable to contact slurm controller (connect failure)")
    if mode() == "no partition":
        fail("Batch job submission failed: Invalid partition name specified")
    if mode() == "nonsense":
        print("Welcome to the cluster!")
        return
    options = dict(word[2:].split("=", 1) for word in sys.argv[1:] if word.startswith("--") and "=" in word)
    command = [word for word in sys.argv[1:] if not word.startswith("--")]
    if mode() == "refuse arrays" and "array" in options:
        fail("Batch job submission failed: Invalid job array specification")
    job = 1 + max([100] + [int(file.stem) for file in (FOLDER / "jobs").glob("*.json")])
    after = options.get("dependency", "").removeprefix("afterany:")
    tasks = range(1 + int(options["array"].split("-")[1])) if "array" in options else [None]
    for number, task in enumerate(tasks):
        write(job + number, job_id=job + number, array_job_id=0 if task is None else job, comment=options["comment"],
              current_working_directory=options["chdir"], job_state="PENDING",
              state_reason="Dependency" if after else "Resources", restart_cnt=0, exit_code=0)
    for number, task in enumerate(tasks):
        # As Slurm does, which copies the script.
        run(job + number, ["/bin/sh", *command], options["chdir"], task, after)
    if mode() == "lose the answer":
        fail("Batch job submission failed: Socket timed out on send/recv operation")
    print(f"{job};cluster" if mode() == "with cluster" else job)


def squeue():
    if mode() == "down":
        fail("slurm_load_jobs error: Unable to contact slurm controller (connect failure)")
    if mode() == "slow":
        time.sleep(60)
    text = json.dumps({"meta": {}, "errors": [], "jobs": all_jobs()})
    print({"nonsense": "Welcome to the cluster!", "cut": text[:len(text) // 2]}.get(mode(), text))


def scancel():
    if mode() == "down":
        fail("Unable to contact slurm controller (connect failure)")
    for name in sys.argv[1:]:
        alive = [job["job_id"] for job in all_jobs() if name in (str(job["job_id"]), str(job.get("array_job_id", 0)))
                 and job["job_state"] in ("PENDING", "RUNNING")]
        if not alive:
            fail(f"Kill job error on job id {name}: Invalid job id specified")
        for job in alive:
            write(job, job_state="CANCELLED")
            if pid := json.loads((FOLDER / "jobs" / f"{job}.json").read_text()).get("pid"):
                os.kill(pid, signal.SIGTERM)


with open(FOLDER / "calls", "a") as calls:
    calls.write(json.dumps([NAME, *sys.argv[1:]]) + "\n")
{"sbatch": sbatch, "squeue": squeue, "scancel": scancel}[NAME]()
