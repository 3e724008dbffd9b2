// What the listeners say where an address is taken. Clients without --server would go on to the server that is there.
#ifndef DOCENT_KB_SERVER_DOOR_PORT_IN_USE_H_
#define DOCENT_KB_SERVER_DOOR_PORT_IN_USE_H_

namespace docent::server {

inline constexpr char kPortInUse[] =
    "; another program listens there, such as a docent that is a service (systemctl stop docent ends it)";

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_PORT_IN_USE_H_
