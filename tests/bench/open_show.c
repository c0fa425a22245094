/* open_show SHOW [COUNT] - what opening a show for reading and asking for its takes costs: the
 * least of COUNT (300) times, in microseconds. open_show.sh compares two builds of it. */
#include "base/clock.h"
#include "show/show.h"

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv)
{
    int64_t least_ns = INT64_MAX;
    const int count = argc > 2 ? atoi(argv[2]) : 300;
    for (int i = 0; argc > 1 && i < count; ++i) {
        error err = {""};
        show *s;
        show_take *takes;
        size_t take_count;
        const int64_t begun_ns = clock_now_ns();
        if (show_open(&s, argv[1], SHOW_READ, &err) < 0 ||
            show_takes(s, &takes, &take_count, &err) < 0) {
            fprintf(stderr, "open_show: %s\n", err.text);
            return 1;
        }
        free(takes);
        show_close(s);
        const int64_t took_ns = clock_now_ns() - begun_ns;
        least_ns = took_ns < least_ns ? took_ns : least_ns;
    }
    printf("%.1f\n", (double)least_ns / 1e3);
    return 0;
}
