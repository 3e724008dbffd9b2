"""What groups of visitors do: they come, ask, give up waiting, and follow their robot. A part of Day."""
from robots import MUSEUM, minutes_to_us
from server_time import text_of


class GroupLife:
    def schedule(self):
        for group in self.plan.groups:
            self.at_time(self.time_of(group.minute), lambda g=group: self.arrive(g))
            for request in group.requests:
                self.at_time(self.time_of(request.minute), lambda g=group, r=request: self.ask(g, r))
        robot, out, back = self.plan.out_of_service
        self.at_time(self.time_of(out), lambda: self.service(robot, True))
        self.at_time(self.time_of(back), lambda: self.service(robot, False))

    def arrive(self, group):
        self.at[group.name] = "Entrance"
        self.places[group.name] = self.places["Entrance"]
        self.show(self.clock.now_us, f"{group.name} comes in: {', '.join(group.visitors)}")
        chair = f"museum:{group.visitors[0]} museum:wheelchair true . " if group.wheelchair else ""
        self.tell(group.name, f"museum:{group.name} a museum:Group ; docent:isAt museum:Entrance . {chair}" + "".join(
            f"museum:{v} a docent:Visitor ; museum:memberOf museum:{group.name} . " for v in group.visitors))

    def ask(self, group, request):
        wants = {"Guide": "a tour", "Carry": "its bags carried", "FirstAid": f"the first aid box at {request.place}"}[request.kind]
        self.show(self.clock.now_us, f"{group.name} wants {wants}{' about ' + ' and '.join(request.interests) if request.interests else ''}")
        facts = [f"museum:{request.name} a museum:{request.kind}Request ; museum:by museum:{group.name}",
                 f'museum:askedAt "{text_of(self.clock.now_us)}"^^xsd:dateTime']
        facts += [f'museum:language "{request.language}"'] if request.language else []
        facts += [f'museum:interest "{theme}"' for theme in request.interests]
        facts += [f"museum:place museum:{request.place}"] if request.place else []
        ring = {"Guide": "tour", "Carry": "bags"}.get(request.kind)
        event = f' [] a docent:Event ; docent:operation "{ring}" ; museum:asks museum:{request.name} .' if ring else ""
        self.tell(group.name, " ; ".join(facts) + " ." + event)
        if request.patience_min:
            self.at_time(self.clock.now_us + minutes_to_us(request.patience_min), lambda: self.give_up(group, request))

    def give_up(self, group, request):
        if any(c.arguments.get("place") == MUSEUM + group.name for r in self.robots.values() for c in r.done + r.active()):
            return
        self.show(self.clock.now_us, f"{group.name} does not wait any longer")
        self.tell(group.name, f'museum:{request.name} museum:givenUp "the group did not want to wait" .')

    def move(self, group, place):
        self.at[group], self.places[group] = place, self.places[place]
        self.tell(group, f"museum:{group} docent:isAt museum:{place} .")
