/* camera_lock.h - the port that "Use the camera" opens is one of the machine's: whoever tests it
 * has it alone, also where two builds are tested at a time. ctest's RESOURCE_LOCK does so within
 * one. */
#ifndef TESTS_WINDOW_CAMERA_LOCK_H
#define TESTS_WINDOW_CAMERA_LOCK_H
#include <fcntl.h>
#include <sys/file.h>

/* Until the test ends. Somebody else's file may not be opened: then nobody waits. */
static inline void camera_lock(void)
{
    const int file = open("/tmp/marotte_test_camera_port", O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file >= 0)
        (void)flock(file, LOCK_EX);
}

#endif
