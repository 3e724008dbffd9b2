"""The plan of the day: who comes when, what they ask for, and what goes wrong. The same for the same seed.

Times are minutes after 09:00 of the museum's clock. What a group is served, and why not, follows from the plan alone, with room
of some minutes; which robot serves it, and when, does not.
"""
import dataclasses
import random

LANGUAGES = ("en", "de", "fr", "es")
THEMES = ("machines", "water", "light", "sound")
VISITORS = 60


@dataclasses.dataclass
class Request:
    name: str                 # G07-tour1
    kind: str                 # Guide, Carry or FirstAid
    minute: float
    language: str = ""
    interests: tuple = ()
    place: str = ""           # of Carry and FirstAid
    patience_min: float = 0   # gives up after this; 0: never


@dataclasses.dataclass
class Group:
    name: str
    minute: float             # of arrival
    size: int
    wheelchair: bool = False
    visitors: list = dataclasses.field(default_factory=list)
    requests: list = dataclasses.field(default_factory=list)


@dataclasses.dataclass
class Plan:
    groups: list
    # The robot that carries out this operation for this group dies in the middle of it, for so many minutes; once.
    failures: list            # (group, operation, number of the group's commands of this operation, minutes)
    out_of_service: tuple     # (robot, from minute, until minute)
    end_minute: float = 10.5 * 60

    def requests(self):
        return [request for group in self.groups for request in group.requests]


def make_plan(seed=4):
    dice = random.Random(seed)
    groups, failures = [], []

    def group(minute, size, **others):
        groups.append(Group(f"G{len(groups) + 1:02}", minute + dice.uniform(0, 0.3), size, **others))
        return groups[-1]

    def tour(of, after=1.0, language=None, themes=1, patience_min=0.0):
        number = sum(1 for r in of.requests if r.kind == "Guide") + 1
        of.requests.append(Request(f"{of.name}-tour{number}", "Guide", of.minute + after, language or dice.choice(LANGUAGES),
                                   tuple(sorted(dice.sample(THEMES, themes))), patience_min=patience_min))

    def bags(of, after=0.5):
        of.requests.append(Request(f"{of.name}-bags", "Carry", of.minute + after, place="Cloakroom"))

    for number in range(6):  # the morning
        comes = group(6 + 14 * number + dice.uniform(-3, 3), dice.randint(1, 4), wheelchair=number == 2)
        tour(comes, themes=dice.choice((1, 2)))
        if number in (1, 4):
            bags(comes)
    for number in range(9):  # before noon they all come
        comes = group(150 + number / 3, dice.randint(1, 4), wheelchair=number == 5)
        tour(comes, language="en")
        if number < 7:  # one is served, four wait, and two are too many
            bags(comes, after=5 + number / 10)
    for number in range(2):  # these two do not wait as long as it takes
        tour(group(154 + number, dice.randint(1, 2)), after=0.5, language="en", patience_min=5)
    emergency = groups[8]
    emergency.requests.append(Request(f"{emergency.name}-aid", "FirstAid", emergency.minute + 8, place="E05"))
    tour(group(215, 2), language="sv")  # which no robot speaks
    twice = group(225, 3)
    tour(twice, themes=1)
    tour(twice, after=1.2, themes=1)  # waits until the first has ended
    handed_over = group(255, 2)
    tour(handed_over, language="de", themes=1)
    failures.append((handed_over.name, "lead", 2, 20.0))
    lost_bags = group(310, 2)
    bags(lost_bags)
    tour(lost_bags)
    failures.append((lost_bags.name, "bringToCloakroom", 1, 0.0))
    for number in range(2):  # the late afternoon
        comes = group(385 + 40 * number, dice.randint(1, 3))
        tour(comes, themes=2)
        if number == 0:
            comes.requests.append(Request(f"{comes.name}-aid", "FirstAid", comes.minute + 4, place="E11"))
    tour(group(490, 1))
    tour(group(521, 2))  # too late for a tour
    grow(groups, dice)
    return Plan(groups, failures, ("R2", 180, 270))


def grow(groups, dice):
    """To sixty visitors in all, with their names."""
    while sum(g.size for g in groups) != VISITORS:
        change = dice.choice(groups)
        change.size += 1 if sum(g.size for g in groups) < VISITORS else -1 if change.size > 1 else 0
    number = 0
    for each in groups:
        for _ in range(each.size):
            number += 1
            each.visitors.append(f"V{number:02}")
