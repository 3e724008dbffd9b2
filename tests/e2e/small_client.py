#!/usr/bin/env python3
"""A small client: asks by HTTP again and again, in a process of its own, so that what the test itself does is not in its times.

    small_client.py HOST:PORT     prints a line when it has begun, asks until its standard input ends, and prints
                                  {"refused": […], "milliseconds": […]}
"""
import json
import select
import subprocess
import sys
import time
import urllib.error
import urllib.request


LEAST = 4  # questions, however short the time


class SmallClient:
    def __init__(self, address):
        self.process = subprocess.Popen([sys.executable, "-B", __file__, address], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.process.stdout.readline()

    def stop(self):
        """What was refused, and how long each answer took."""
        said = json.loads(self.process.communicate(timeout=130)[0])
        return said["refused"], sorted(said["milliseconds"])

    def end(self):
        self.process.kill()
        self.process.communicate()


def main(address):
    refused, milliseconds = [], []
    print("begun", flush=True)
    while len(milliseconds) + len(refused) < LEAST or not select.select([sys.stdin], [], [], 0.05)[0]:
        begin = time.monotonic()
        try:
            with urllib.request.urlopen(f"http://{address}/sparql?query=ASK%7B%7D", timeout=120) as reply:
                reply.read()
            milliseconds.append(round(1000 * (time.monotonic() - begin), 1))
        except urllib.error.HTTPError as error:
            refused.append(f"{error.code} {error.read().decode()}")
        except OSError as error:
            refused.append(str(error))
    print(json.dumps({"refused": refused, "milliseconds": milliseconds}))


if __name__ == "__main__":
    main(sys.argv[1])
