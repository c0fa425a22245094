/* print_card: writes the lines of the card for a hand tracked as points, as the script card.js of
 * the camera's page. */
#include "card.h"
#include "joints.h"
#include "settings.h"

#include <stdio.h>

int main(void)
{
    double params[SET_COUNT] = {0.0};
    uint32_t count;
    params[SET_DEVICE] = 1.0 + DEVICE_POINTS;
    const mrt_card_line *line = card_lines(params, NULL, MRT_RIGHT, &count);
    (void)printf("'use strict';\nconst CARD = [\n");
    for (uint32_t i = 0; i < count; ++i) {
        (void)printf("  {hand: '%s', face: '%s', perRad: [", line[i].hand, line[i].face);
        for (int k = 0; k < MRT_ANGLES; ++k)
            (void)printf("%s%g", k > 0 ? ", " : "", (double)line[i].per_rad[k]);
        (void)printf("]},\n");
    }
    (void)printf("];\n");
    return 0;
}
