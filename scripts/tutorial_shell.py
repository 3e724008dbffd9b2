"""A shell that runs a tutorial's commands one by one and hears what they print. Standard library only."""
import os
import re
import signal
import subprocess
import threading
import time

from tutorial_blocks import INTERRUPT, compare

END = "\x01END"
PATIENCE_S = 120  # for one command
SILENCE_S = 30    # after which something that goes on printing has printed enough


def hear_interrupts():
    """A caller in the background (`nohup … &`) may ignore them, and then so would the shell and all its commands."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


class Terminal:
    """One bash. Output and errors come together, as on a screen. Commands see no terminal, so nothing is coloured.

    root: the folder is in this system, and the shell is that system's."""

    def __init__(self, folder, environment, root=None):
        commands, self.commands = os.pipe()
        shell = ["bash", "--norc", f"/dev/fd/{commands}"]
        argv = ["/usr/sbin/chroot", root, "env", "-C", f"/{folder.relative_to(root)}", *shell] if root else shell
        self.bash = subprocess.Popen(argv, cwd=folder, env=environment, pass_fds=[commands],
                                     stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                     start_new_session=True, preexec_fn=hear_interrupts)
        os.close(commands)
        self.changed = threading.Condition()
        self.output, self.closed = "", False
        self.count = 0        # commands given
        self.running = False  # the last one was left running
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self):
        while piece := os.read(self.bash.stdout.fileno(), 65536):
            with self.changed:
                self.output += piece.decode(errors="replace")
                self.changed.notify_all()
        with self.changed:
            self.closed = True
            self.changed.notify_all()

    def _end(self):
        """Where the last command's end stands in the output, or None."""
        return re.search(f"{END} {self.count}\n", self.output)

    def _lines(self):
        """What is printed in whole lines, and once the command has ended, what it left in the last one."""
        text = self.output if self._end() else self.output[:self.output.rfind("\n") + 1]
        text = re.sub(f"{END} \\d+\n", "", text).replace("\r\n", "\n")
        return [line.rstrip() for line in text.removesuffix("\n").split("\n")] if text else []

    def give(self, command):
        if command == INTERRUPT:
            self._interrupt()
            return
        self.count += 1
        self.output = ""
        os.write(self.commands, f"{command}\nprintf '{END} %s\\n' {self.count}\n".encode())

    def _interrupt(self):
        """As Ctrl-C: to what runs in the foreground, not to the shell."""
        self.output = ""
        for pid in children(self.bash.pid):
            os.kill(pid, signal.SIGINT)

    def expect(self, expected, leave_running, background, known=True):
        """Waits until the last command has ended and has printed this; the lines that it has printed.

        leave_running: it goes on after the output; background: it has ended at once, and the output comes later.
        known False: it may print something else; what goes on printing has printed enough after some seconds of silence."""
        deadline = time.monotonic() + PATIENCE_S
        silent, length = time.monotonic(), 0
        with self.changed:
            while True:
                if len(self.output) != length:
                    silent, length = time.monotonic(), len(self.output)
                right = compare(expected, self._lines()) is None
                if not known:
                    right = (right and expected) or time.monotonic() > silent + SILENCE_S
                if leave_running:
                    done = right or (known and self._end() is not None)
                elif background:
                    done = right and self._end() is not None
                else:
                    done = self._end() is not None
                if done or self.closed or time.monotonic() > deadline:
                    break
                self.changed.wait(0.2)
            lines = self._lines()
            if not done:
                lines.append("(the shell has ended)" if self.closed else f"(waited {PATIENCE_S} s for the end of this)")
            self.output = ""
            return lines

    def close(self):
        """Ends the shell and everything that it started."""
        os.close(self.commands)
        for number in (signal.SIGTERM, signal.SIGKILL):
            try:
                os.killpg(self.bash.pid, number)
            except ProcessLookupError:
                break
            end = time.monotonic() + 10
            while time.monotonic() < end and group_lives(self.bash.pid):
                self.bash.poll()
                time.sleep(0.02)
        self.bash.wait()


def children(parent):
    found = []
    for entry in os.listdir("/proc"):
        if entry.isdigit():
            try:
                with open(f"/proc/{entry}/stat") as file:
                    if int(file.read().rsplit(")", 1)[1].split()[1]) == parent:
                        found.append(int(entry))
            except OSError:
                pass  # it has ended meanwhile
    return found


def group_lives(group):
    try:
        os.killpg(group, 0)
        return True
    except (ProcessLookupError, PermissionError):
        return False
