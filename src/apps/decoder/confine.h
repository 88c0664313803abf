// Gives up what a decoder does not need.
#pragma once

namespace sfumato {

/// From now on only system calls that compute and that send and receive packets of open sockets: any other
/// ends the process (SIGSYS). Nothing where the kernel cannot (no seccomp) or the processor is not known
/// here. Null, or what went wrong.
const char* confine();

}  // namespace sfumato
