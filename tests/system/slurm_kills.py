"""Kills at random of the service, workers, the node and the controller while jobs run at Slurm."""

import os
import signal
import threading
import time

from slurm_world import FINAL


class Killer:
    """Kills whatever there is, at random."""

    def __init__(self, world, rng):
        self.world, self.rng = world, rng
        self.counts = {}

    def kill(self):
        ways = (self.service, self.service, self.worker, self.worker, self.runner, self.node, self.controller)
        way = self.rng.choice(ways)
        self.counts[way.__name__] = self.counts.get(way.__name__, 0) + bool(way())

    def service(self):
        self.world.stop()
        time.sleep(self.rng.uniform(0, 2))
        self.world.start()
        return True

    def process(self, word):
        found = self.world.processes(word)
        if found:
            os.kill(self.rng.choice(found), signal.SIGKILL)
        return bool(found)

    def worker(self):
        return self.process("work")

    def runner(self):
        return self.process("run-attempt")

    def node(self):
        self.world.slurm.lose_node(self.world.processes("work") + self.world.processes("run-attempt"))
        time.sleep(self.rng.uniform(0, 2))
        return self.world.slurm.return_node()

    def controller(self):
        self.world.slurm.kill("slurmctld")
        time.sleep(self.rng.uniform(0, 2))
        self.world.slurm.start_controller()
        return True


def survive_kills(world, kills, rng):
    """What is wrong after `kills` kills: jobs that were lost, or published twice or by halves."""
    jobs, is_over = {}, threading.Event()

    def upload():
        while not is_over.is_set():
            try:
                active = sum(1 for state in ("queued", "running")
                             for _ in world.ask("GET", f"/api/v1/jobs?state={state}")[1]["items"])
                if active < 6:
                    jobs[world.upload(rng.choice(("ok", "slow", "slow")), site=f"lot{rng.randrange(6)}")] = None
            except (OSError, AssertionError, ValueError):
                pass  # killed meanwhile: not acknowledged
            is_over.wait(0.3)

    uploader = threading.Thread(target=upload)
    uploader.start()
    killer = Killer(world, rng)
    while sum(killer.counts.values()) < kills:
        time.sleep(rng.uniform(0.2, 2.5))
        killer.kill()
    is_over.set()
    uploader.join()
    print(f"  {killer.counts}", flush=True)

    wrong, ends = [], {}
    for job in jobs:
        try:
            found = world.wait(job, *FINAL, seconds=300)
        except AssertionError as error:
            wrong.append(f"lost: {error}")
            continue
        ends[found["state"]] = ends.get(found["state"], 0) + 1
        jobs[job] = found
        # Three crashes of one job are its end.
        if found["state"] != "done" and (found["error_code"] != "crashed" or found["attempts"] < 3):
            wrong.append(f"ended badly: {found}")
    of_job = {}
    for site, version in world.versions():
        manifest = world.ask("GET", f"/api/v1/sites/{site}/maps/{version}")[1]
        of_job.setdefault(manifest["job"], []).append(version)
        for file in manifest["files"]:
            if world.service.ask("GET", file["url"])[0] != 200:
                wrong.append(f"{file['url']} is visible and damaged")
    wrong += [f"job {job} published {versions}" for job, versions in of_job.items() if len(versions) > 1]
    wrong += [f"job {job} is done without a map" for job, found in jobs.items()
              if found and found["state"] == "done" and of_job.get(job) != [found["map_version"]]]
    time.sleep(8)  # strays are ended
    wrong += [f"stray at Slurm: {job}" for job in world.active_at_slurm()]
    wrong += [f"left behind: {path}" for path in world.left_behind()]
    print(f"  {sum(killer.counts.values())} kills, {len(jobs)} jobs acknowledged, {ends}, {len(wrong)} wrong", flush=True)
    return wrong
