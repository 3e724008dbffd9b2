"""Scenario s03 on a stage (docent_stage.py): what it loads, its two robots, and John. Standard library only."""
import threading

from docent_stage import EXPO, ROOT, S01, load_ontology, wait_until

S03 = ROOT / "scenarios" / "s03_johns_service"
SENSORS, PHONE = "urn:docent:source:sensors", "urn:docent:source:johns-phone"


def load_s03(server):
    """The hall and the booth guide of s01, then what John's Service adds to them."""
    load_ontology(server)
    server.load(S01 / "hall.ttl", S03 / "world.ttl", S01 / "guide.rules", S03 / "profiles.rules")
    server.load(S01 / "booth_guide.rsel.xml", S03 / "talk.rsel.xml")
    server.load(S01 / "booth_guide.cawl.xml", S03 / "johns_service.cawl.xml")


def robots(stage, server, seed=1, speed=1.0):
    """R01, which speaks English and stands at booth B11, and R02, which speaks German, too, and stands at the dock."""
    one = stage.robot(server, name="R01", folder="R01", seed=seed, speed=speed, arguments=["--start", EXPO + "B11"])
    two = stage.robot(server, name="R02", folder="R02", seed=seed + 1, speed=speed)
    return one, two


class John(threading.Thread):
    """Comes in, asks for John's Service, follows the robot to each booth, and rates the tour at the end. What he does is
    told as the scenario's sensors and his phone would tell it."""

    def __init__(self, server, rating=5, patience_s=300, on_step=lambda words, fact: None):
        super().__init__(daemon=True)
        self.server, self.rating, self.patience_s, self.on_step = server, rating, patience_s, on_step
        self.seen = []  # booths to which he was led
        self.error = None

    def run(self):
        try:
            self.reading("expo:DoorSensor", "expo:Entrance", "John comes in; the door sensor reads his badge")
            self.tell("expo:John docent:chose expo:JohnsService", "John asks for John's Service on his phone")
            while self.next_booth():
                booth = self.seen[-1]
                self.reading(f"{booth}Beacon", booth, "John has followed the robot; the booth's beacon reads his badge")
            self.tell(f"expo:John docent:rated {self.rating}", "John rates the tour on his phone")
        except Exception as error:  # shown by whoever joins this thread
            self.error = error

    def next_booth(self):
        """Waits until his robot stands at a booth where he is not yet, or he is asked how he liked it (False)."""
        def happened():
            if self.server.ask('?node docent:nodeName "Answer" ; docent:nodeState "waiting"'):
                return "asked"
            rows = self.server.select("""SELECT ?booth { expo:John docent:selected ?booth ; docent:isAt ?here .
                ?run docent:flow "JohnsService" ; docent:usesRobot ?robot .
                ?robot docent:isAt ?booth ; docent:status docent:Standby FILTER(?here != ?booth) }""")
            return rows[0]["booth"] if rows else None
        found = wait_until(happened, self.patience_s, "the robot to lead John to a booth, or to ask him")
        if found != "asked":
            self.seen.append(found)
        return found != "asked"

    def tell(self, fact, words):
        self.on_step(words, fact)
        self.server.tell(fact, source=PHONE)

    def reading(self, sensor, place, words):
        self.on_step(words, f"expo:John docent:isAt {place}")
        self.server.tell(readings=[(sensor, "tag-17")], source=SENSORS)
