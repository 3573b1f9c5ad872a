// What only C can say of the process, or do to it.
#include "osd.h"

#include <cerrno>
#include <csignal>
#include <cstring>
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

constexpr int FATAL[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};
constexpr char const *NAMES[] = {"SIGSEGV", "SIGBUS", "SIGILL", "SIGFPE", "SIGABRT"};

// Only what a signal handler may do: write, and end.
void end_with_one_line(int signal) {
    char const *name = "a signal";
    for (int i = 0; i < 5; ++i)
        if (FATAL[i] == signal) name = NAMES[i];
    char const *const parts[] = {
        "catoptric: a library that this program calls (OpenSubdiv, or the driver of the adapter) ended with ", name,
        "; catoptric verify MESH says whether it is OpenSubdiv; please report it with the mesh\n"};
    for (char const *part : parts) {
        // Where nobody takes it, the end is the same.
        ssize_t const written = write(STDERR_FILENO, part, std::strlen(part));
        static_cast<void>(written);
    }
    _exit(2);
}

}  // namespace

extern "C" void osd_name_fatal_signals(void) {
    struct sigaction action {};
    action.sa_handler = end_with_one_line;
    action.sa_flags = SA_ONSTACK | SA_RESETHAND; // the stack itself may be what overflowed
    for (int signal : FATAL) sigaction(signal, &action, nullptr);
}

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
