#!/usr/bin/env python3
"""How long drives wait for their maps at a cluster of so many nodes, and what runs out first.

    load_study.py REPORT.json LOG [--nodes 100] [--cores 16] [--cpus 4] ...

Costs are measured: REPORT.json is of a map that `parkade map` made from LOG, one drive alone. From it
come processor time per second of drive, how well more processors are used, and bytes. Arrivals are
simulated over three days, of which the last counts: most drives come in the evening. Jobs of one site
run one after the other, as the service has it; a job holds its processors until its map is published.
The commits of one drive (--commits) are counted in the code: upload, first look, claim, three of the
engine, publishing, events around them.
"""

import argparse
import heapq
import json
import os
import pathlib
import random
import statistics

DAY = 86_400.0
EVENING = (16 * 3600, 22 * 3600)  # [s] of the day, with this share of the drives
EVENING_SHARE = 0.6
PART_BYTES = 64e6  # of a resumable upload: one commit each


class Costs:
    def __init__(self, report, log, cores_used, factor):
        content = json.loads(report.read_text())
        self.drive_seconds = sum(drive["duration"] for drive in content["drives"])
        self.stages = {stage["name"]: stage["processor_seconds"] * factor / self.drive_seconds
                       for stage in content["stages"]}
        self.processor = sum(self.stages.values())  # [s] per second of drive
        wall = sum(stage["seconds"] for stage in content["stages"])
        self.cores_used = cores_used or sum(stage["processor_seconds"] for stage in content["stages"]) / wall
        self.log_rate = factor * log.stat().st_size / self.drive_seconds  # [bytes/s]
        products = sum(file.stat().st_size for file in report.parent.rglob("*") if file.is_file())
        self.product_rate = products / self.drive_seconds

    def wall(self, length, cpus, measured_cpus):
        """[s] Amdahl's law through the measured use of `measured_cpus`."""
        serial = max(0.0, (measured_cpus / self.cores_used - 1) / (measured_cpus - 1)) if measured_cpus > 1 else 0.0
        return length * self.processor * (serial + (1 - serial) / cpus)


def arrivals(rng, drives_per_day, days):
    times = []
    for day in range(days):
        for _ in range(drives_per_day):
            begin, end = EVENING if rng.random() < EVENING_SHARE else (0, DAY)
            times.append(day * DAY + rng.uniform(begin, end))
    return sorted(times)


def simulate(rng, costs, arguments, drives_per_day):
    """[s] from arrival to start, of the last day's jobs; and the share of time that processors were busy."""
    slots = arguments.nodes * (arguments.cores // arguments.cpus)
    slots = min(slots, arguments.workers)
    waiting, busy_sites, running = [], set(), []
    queue_times, busy_seconds = [], 0.0
    pending = [(time, rng.randrange(arguments.sites), rng.lognormvariate(0, 0.6) * arguments.length)
               for time in arrivals(rng, drives_per_day, 3)]
    pending.reverse()
    while pending or waiting or running:
        now = min(pending[-1][0] if pending else float("inf"), running[0][0] if running else float("inf"))
        while pending and pending[-1][0] <= now:
            waiting.append(pending.pop())
        while running and running[0][0] <= now:
            busy_sites.discard(heapq.heappop(running)[1])
        left = []
        for i, job in enumerate(waiting):
            arrived, site, length = job
            if len(running) >= slots:
                left += waiting[i:]
                break
            if site in busy_sites:
                left.append(job)
                continue
            wall = costs.wall(length, arguments.cpus, arguments.measured_cpus) + arguments.overhead
            heapq.heappush(running, (now + wall, site))
            busy_sites.add(site)
            if 2 * DAY <= arrived:
                queue_times.append(now - arrived)
                busy_seconds += wall
        waiting = left
    return queue_times, busy_seconds / (slots * DAY)


def peak_use(costs, arguments, drives_per_day):
    """Of the busiest hours: shares of the database's commits and of the shared disk's bandwidth."""
    per_second = drives_per_day * EVENING_SHARE / (EVENING[1] - EVENING[0])
    per_second += drives_per_day * (1 - EVENING_SHARE) / DAY
    log = costs.log_rate * arguments.length * 1.2  # the mean is above the median
    commits = arguments.commits + log / PART_BYTES
    # Written once; read to hash it, by the first look, before the job, and by the worker.
    # What is made is written once and read once to be hashed.
    traffic = 4 * log + 2 * costs.product_rate * arguments.length * 1.2
    return per_second * commits / arguments.commits_per_second, per_second * traffic / arguments.disk


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("report", type=pathlib.Path)
    parser.add_argument("log", type=pathlib.Path)
    parser.add_argument("--nodes", type=int, default=100)
    parser.add_argument("--cores", type=int, default=16, help="of a node")
    parser.add_argument("--cpus", type=int, default=4, help="of a job (--job-cpus)")
    parser.add_argument("--workers", type=int, default=512, help="jobs at Slurm at a time (--workers)")
    parser.add_argument("--measured-cpus", type=int, default=os.cpu_count(), help="of the machine of REPORT.json")
    parser.add_argument("--cores-used", type=float, help="of these, where that machine was busy with other work")
    parser.add_argument("--factor", type=float, default=1, help="for more or larger images: of processor time and log")
    parser.add_argument("--sites", type=int, default=1000)
    parser.add_argument("--length", type=float, default=600, help="[s] median of drives")
    parser.add_argument("--overhead", type=float, default=15, help="[s] of a job at Slurm and in the service")
    parser.add_argument("--commits", type=float, default=9, help="of one drive and its job")
    parser.add_argument("--commits-per-second", type=float, default=343)
    parser.add_argument("--disk", type=float, default=1.0e9, help="[bytes/s] of the shared disk")
    parser.add_argument("--drives", type=int, nargs="*", default=[1000, 3000, 6000, 10_000, 15_000, 20_000, 30_000])
    arguments = parser.parse_args()
    costs = Costs(arguments.report, arguments.log, arguments.cores_used, arguments.factor)
    print(f"measured: {costs.processor:.2f} processor s per s of drive, {costs.cores_used:.2f} of "
          f"{arguments.measured_cpus} processors in use, log {costs.log_rate / 1e6:.2f} MB/s, "
          f"map {costs.product_rate / 1e6:.2f} MB/s")
    for name, cost in costs.stages.items():
        print(f"  {name:16} {cost:6.3f}")
    print("drives/day  processors   queue: median     95 %      max [s]   commits   disk (peak hours)")
    for drives in arguments.drives:
        queue_times, busy = simulate(random.Random(1), costs, arguments, drives)
        ordered = sorted(queue_times)
        commits, disk = peak_use(costs, arguments, drives)
        print(f"{drives:10}  {busy:9.0%}  {statistics.median(ordered):14.0f} {ordered[int(0.95 * len(ordered))]:8.0f} "
              f"{ordered[-1]:8.0f}      {commits:9.1%} {disk:8.0%}")


if __name__ == "__main__":
    main()
