// What only C can say of the process, or do to it.
#include "osd.h"

#include <cerrno>
#include <fcntl.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace {

// Rust opens /dev/null in the place of a standard stream that is closed, before any code of ours runs: afterwards nothing tells it from
// a stream that somebody meant to discard. This is asked before.
bool stdout_was_closed = false;

__attribute__((constructor)) void look_at_stdout() {
    stdout_was_closed = fcntl(STDOUT_FILENO, F_GETFD) == -1 && errno == EBADF;
}

}  // namespace

extern "C" int32_t osd_stdout_was_closed(void) {
    return stdout_was_closed ? 1 : 0;
}

extern "C" void osd_share_one_arena(void) {
#ifdef __GLIBC__
    mallopt(M_ARENA_MAX, 1);
#endif
}

extern "C" void osd_end_process(int32_t code) {
    _exit(code);
}
