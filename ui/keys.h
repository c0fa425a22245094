/* keys.h - single keys from the terminal, without waiting and without an echo. Where standard input
 * is no terminal there are none. The terminal is put back by keys_end and when the program exits.
 * [main] */
#ifndef MAROTTE_UI_KEYS_H
#define MAROTTE_UI_KEYS_H
#include <stdbool.h>

/* False: no terminal, or this process is not in its foreground. Ctrl-C stays a signal. */
bool keys_begin(void);
void keys_end(void); /* also when keys_begin said false */
/* The next key that was pressed, '\n' for Enter; 0: none. */
char keys_next(void);

#endif
