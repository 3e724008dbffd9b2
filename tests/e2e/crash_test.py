#!/usr/bin/env python3
"""kill -9 during a mixed load, a full disk, backups of a running server: no acknowledged batch is lost, none is half there.
DOCENT_E2E_CRASHES sets how often the server is killed (scripts/soak: 50), DOCENT_E2E_SEED repeats a choice of moments."""
import json
import os
import random
import shutil
import sqlite3
import subprocess
import time
import unittest

from crash_load import Load
from docent_e2e import PATIENCE_S, StageTest, stage

CRASHES = int(os.environ.get("DOCENT_E2E_CRASHES", "6"))
SMALL = ["--snapshot-records", "300", "--history-bytes", "1000000"]


class Crash(StageTest):
    def verify(self, folder, code=0):
        done = self.docent("verify", "--json", folder)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return json.loads(done.stdout)

    def test_kill_nine_during_a_mixed_load(self):
        seed = int(os.environ.get("DOCENT_E2E_SEED", random.randrange(1 << 30)))
        print(f"seed {seed}", flush=True)
        moments = random.Random(seed)
        server = self.stage.server(arguments=SMALL)
        stage.load_s01(server)
        with Load(server) as load:
            for _ in range(CRASHES):
                before = load.acknowledged()
                time.sleep(moments.uniform(0.05, 1.5))
                stage.wait_until(lambda: load.acknowledged() > before, PATIENCE_S, "acknowledgements")
                server.kill()
                self.verify(server.data)
                server.start()
                self.assertEqual(load.faults(), [])
        self.assertEqual(load.faults(), [])
        report = self.verify(server.data)
        self.assertTrue(report["snapshots"], "no snapshot was taken")
        print(f"{CRASHES} kills, {load.acknowledged()} acknowledged batches, snapshots {report['snapshots']}", flush=True)
        server.stop()
        server.start()
        self.assertEqual(load.faults(), [])
        report = self.verify(server.data)
        self.assertEqual(report["snapshots"][-1], report["last"], "an orderly end leaves a snapshot of the last turn")

    def test_a_full_disk_refuses_writes_and_goes_on_when_there_is_room(self):
        folder = self.stage.folder / "small"
        folder.mkdir()
        if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=12m", "tmpfs", folder]).returncode != 0:
            print("mounting needs root; tests/graph/log covers a full disk without it")
            return
        self.addCleanup(subprocess.run, ["umount", folder])
        server = self.stage.server(data="small/data", arguments=SMALL)
        self.addCleanup(server.stop)
        with Load(server) as load:
            stage.wait_until(lambda: load.acknowledged() > 50, PATIENCE_S, "acknowledgements")
            filler = folder / "filler"
            with open(filler, "wb", buffering=0) as file:
                try:
                    while True:
                        file.write(b"x" * 4096)
                except OSError:
                    pass
            stage.wait_until(lambda: all(w.refusals for w in load.writers), PATIENCE_S, "refusals")
            self.assertRegex(load.writers[0].refusals[-1], "disk|full|room")
            self.assertTrue(server.ask("?s <urn:load:part> 0"), "reads go on")
            self.assertTrue(server.process.running())
            filler.unlink()
            before = load.acknowledged()
            stage.wait_until(lambda: load.acknowledged() > before + 50, PATIENCE_S, "writing to go on")
        self.assertEqual(load.faults(), [])
        server.kill()
        server.start()
        self.assertEqual(load.faults(), [])

    def test_a_backup_of_a_running_server_is_whole_and_can_be_restored(self):
        server = self.stage.server(arguments=SMALL)
        with Load(server) as load:
            stage.wait_until(lambda: load.acknowledged() > 400, PATIENCE_S, "acknowledgements")
            before = {w.name: list(w.acknowledged) for w in load.writers}
            target = self.stage.folder / "backup"
            done = self.docent("backup", target, "--data", server.data)
            self.assertEqual(done.returncode, 0, done.stderr)
            stage.wait_until(lambda: load.acknowledged() > 500, PATIENCE_S, "acknowledgements")
        last = self.verify(target)["last"]
        restored = self.stage.folder / "restored"
        self.assertEqual(self.docent("restore", target, "--data", restored).returncode, 0)
        self.assert_refused(self.docent("restore", target, "--data", restored), 2, str(restored), "another place")
        server.stop()
        other = self.stage.server(data="restored")
        there = {row["s"] for row in other.select("SELECT DISTINCT ?s { ?s <urn:load:part> ?p }")}
        for name, numbers in before.items():
            self.assertEqual([n for n in numbers if f"urn:load:{name}:{n}" not in there], [])
        # the past of the backup is there, too
        done = other.run("query", "--as-of", "1", "ASK { ?s <urn:load:part> ?p }")
        self.assertIn(done.returncode, (0, 1), done.stderr)
        done = other.run("query", "--as-of", str(last + 100000), "ASK {}")
        self.assert_refused(done, 2, "newest")

    def test_damage_is_named_and_an_older_snapshot_is_used(self):
        server = self.stage.server(arguments=SMALL)
        with Load(server) as load:
            stage.wait_until(lambda: load.acknowledged() > 800, PATIENCE_S, "acknowledgements")
        server.stop()
        snapshots = sorted(server.data.glob("snapshot-*"))
        self.assertGreaterEqual(len(snapshots), 2)
        damaged = bytearray(snapshots[-1].read_bytes())
        damaged[len(damaged) // 2] ^= 1
        snapshots[-1].write_bytes(damaged)
        self.assertIn(snapshots[-1].name, self.docent("verify", server.data).stderr)
        server.start()
        self.assertIn("of no use", server.process.output())
        self.assertEqual(load.faults(), [])
        server.stop()
        # a record that only history needs: the server has no use for it, but verify names it
        shutil.copytree(server.data, self.stage.folder / "copy")
        with sqlite3.connect(server.data / "log.sqlite") as db:
            data = db.execute("SELECT data FROM ctxlog WHERE seq = 3").fetchone()[0]
            db.execute("UPDATE ctxlog SET data = ? WHERE seq = 3", (bytes([data[0] ^ 1]) + data[1:],))
        db.close()
        done = self.docent("verify", server.data)
        self.assertEqual(done.returncode, 1)
        self.assertIn("log.sqlite: offset 3: ", done.stderr)
        server.start()
        self.assertEqual(load.faults(), [])
        done = server.run("query", "--as-of", "3", "ASK {}")
        self.assert_refused(done, 2, "offset 3")

    def test_a_folder_that_lost_its_log_is_left_alone_and_its_newest_snapshot_can_be_gone_on_from(self):
        server = self.stage.server()
        for number in range(5):
            server.tell(f"<urn:s{number}> <urn:p> {number}")
        server.stop()
        (server.data / "log.sqlite").unlink()
        for name in ("head", "lock"):
            there = sorted(path.name for path in server.data.iterdir())
            self.assert_refused(self.docent("serve", "--data", server.data), 2, "log.sqlite is gone", "snapshots at 5",
                                "restore --from-snapshot")
            self.assertEqual(sorted(path.name for path in server.data.iterdir()), there)
            self.assertEqual(self.verify(server.data, code=1)["snapshots"], [5])
            (server.data / name).unlink()
        done = self.docent("restore", "--from-snapshot", server.data, "--data", self.stage.folder / "saved")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("the snapshot at offset 5", done.stdout)
        saved = self.stage.server(data="saved")
        self.assertEqual(sorted(int(r["o"]) for r in saved.select("SELECT ?o { ?s <urn:p> ?o }")), [0, 1, 2, 3, 4])
        saved.tell("<urn:s5> <urn:p> 5")
        saved.kill()
        saved.start()
        self.assertEqual(len(saved.select("SELECT ?o { ?s <urn:p> ?o }")), 6)
        saved.stop()
        self.assertEqual(self.verify(saved.data)["last"], 6)


if __name__ == "__main__":
    unittest.main()
