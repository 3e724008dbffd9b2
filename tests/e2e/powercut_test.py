#!/usr/bin/env python3
"""Power cuts: the data folder lies on an ext4 of its own (a loop device), which is shut down under the running server so
that nothing reaches the disk any more that was not synced; after the next mount no acknowledged batch may be missing.

Only what was acknowledged before the shutdown began counts. ext4 asks for one at the beginning of an fdatasync alone: that of a
growing file returns 0 if the shutdown has its journal drop the transaction meanwhile (Linux 6.18; a plain program that appends
and syncs sees it in one of ten cuts).

Needs root. DOCENT_E2E_CRASHES sets how often (scripts/soak powercut: 20)."""
import fcntl
import os
import random
import struct
import subprocess
import time
import unittest

from crash_load import Load
from docent_e2e import PATIENCE_S, StageTest, stage

CUTS = int(os.environ.get("DOCENT_E2E_CRASHES", "3"))
SHUTDOWN = 0x8004587D  # EXT4_IOC_SHUTDOWN (Linux fs/ext4/ext4.h)
NO_LOG_FLUSH = 2       # EXT4_GOING_FLAGS_NOLOGFLUSH: the journal is not written either


def must(*command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    if done.returncode != 0:
        raise stage.StageError(f"{' '.join(map(str, command))}: {done.stderr.strip()}")


def shut_down(file_system):
    folder = os.open(file_system, os.O_RDONLY)
    try:
        fcntl.ioctl(folder, SHUTDOWN, struct.pack("I", NO_LOG_FLUSH))
    finally:
        os.close(folder)


class PowerCut(StageTest):
    def test_power_cuts_during_a_mixed_load(self):
        image, disk = self.stage.folder / "disk.img", self.stage.folder / "disk"
        disk.mkdir()
        with open(image, "wb") as file:
            file.truncate(512 << 20)
        must("mkfs.ext4", "-q", "-F", image)
        must("mount", "-o", "loop", image, disk)
        self.addCleanup(lambda: subprocess.run(["umount", "-l", str(disk)], capture_output=True))
        server = self.stage.server(data="disk/data", arguments=["--snapshot-records", "500"])
        self.addCleanup(server.kill)
        moments = random.Random(int(os.environ.get("DOCENT_E2E_SEED", "1")))
        with Load(server) as load:
            for cut in range(CUTS):
                before = load.acknowledged()
                time.sleep(moments.uniform(0.2, 2))
                stage.wait_until(lambda: load.acknowledged() > before, PATIENCE_S, "acknowledgements")
                with load.cut():
                    shut_down(disk)
                    server.kill()
                must("umount", disk)
                must("mount", "-o", "loop", image, disk)
                done = self.docent("verify", server.data)
                self.assertEqual(done.returncode, 0, done.stderr)
                server.start()
                self.assertEqual(load.faults(), [], f"cut {cut}")
                if cut % 2 == 0:  # an orderly end takes the write-ahead log away: the next cut meets a new one that grows
                    server.stop()
                    server.start()
        self.assertEqual(load.faults(), [])
        print(f"{CUTS} power cuts, {load.acknowledged()} acknowledged batches, none lost", flush=True)
        server.kill()
        must("umount", disk)


if __name__ == "__main__":
    unittest.main()
