"""Scenario s05 on a stage (docent_stage.py): what it loads, its robot, and the people of the care home. Standard library
only."""
from docent_stage import PREFIXES, ROOT, load_ontology, wait_until

S05 = ROOT / "scenarios" / "s05_hospital_round"
CARE = "https://w3id.org/docent/care#"
PREFIXES["care"] = CARE
NURSES = "urn:docent:source:nurses"


def load_s05(server, hall=S05 / "hall.ttl"):
    load_ontology(server)
    server.load(hall, S05 / "world.ttl", S05 / "night.rules", S05 / "care.rsel.xml", S05 / "delivery.cawl.xml")


def make_it(server, night):
    """Night or day from now on, whatever the clock of the machine says: the hours of the night are a fact."""
    hours = "00:00-24:00" if night else "00:00-00:01"
    server.command("update", f"""PREFIX docent: <https://w3id.org/docent#> PREFIX care: <{CARE}>
        DELETE {{ GRAPH ?g {{ care:Night docent:between ?hours }} }} INSERT {{ care:Night docent:between "{hours}" }}
        WHERE {{ GRAPH ?g {{ care:Night docent:between ?hours }} }}""")
    server.wait_for(f"care:Night docent:timeHolds {'true' if night else 'false'}", 60)


def robot(stage, server, hall=S05 / "hall.ttl", speed=1.0, seed=1, start=CARE + "RobotDock"):
    return stage.robot(server, name=CARE + "C01", hall=hall, folder="C01", speed=speed, seed=seed, arguments=["--start", start])


def tell(server, facts):
    return server.command("tell", "--prefix", f"care={CARE}", "--source", NURSES, facts)


def event(server, operation, facts):
    """Somebody does something with a delivery and presses the button for it."""
    tell(server, f'{facts} . [] a docent:Event ; docent:operation "{operation}"')


def order(server, name, place, item="care:EveningMedicine", store="care:Pharmacy", urgent=False):
    tell(server, f"care:{name} a care:Delivery ; care:item {item} ; care:from {store} ; care:to {place}"
         + (" ; care:urgent true" if urgent else ""))


def wait_for_node(server, name, node, state, seconds=300):
    """Until a node of the run of the delivery is in this state."""
    wait_until(lambda: server.ask(f"""?run docent:hasVariable ?v . ?v docent:variableName "delivery" ; docent:variableValue care:{name} .
        ?n docent:ofRun ?run ; docent:nodeName "{node}" ; docent:nodeState "{state}" """), seconds, f"{node} of {name} to be {state}")


def wait_for_end(server, name, seconds=300):
    """Until the run of the delivery has ended; its state and reason."""
    def ended():
        return server.select(f"""SELECT ?run ?state ?reason {{ ?run docent:hasVariable ?v ; docent:runState ?state .
            ?v docent:variableName "delivery" ; docent:variableValue care:{name} OPTIONAL {{ ?run docent:reason ?reason }}
            FILTER (?state != "running") }}""")
    row = wait_until(ended, seconds, f"the run of {name} to end")[0]
    return row["run"], row["state"], row.get("reason", "")
