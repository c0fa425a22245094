/* plugins/osc/osc_fault.h - what can be wrong with what others send. Each kind is counted, and said
 * once. Pure. */
#ifndef MAROTTE_OSC_FAULT_H
#define MAROTTE_OSC_FAULT_H

typedef enum osc_fault {
    OSC_FAULT_NONE = 0,
    OSC_FAULT_PACKET,  /* no OSC */
    OSC_FAULT_SIZE,    /* OSC, but more of it than anybody sends */
    OSC_FAULT_ADDRESS, /* a message that nobody here knows */
    OSC_FAULT_TYPES,   /* arguments of other types, or another number of them */
    OSC_FAULT_VALUE,   /* not finite, or out of range */
    OSC_FAULT_SENDER,  /* two senders for one thing */
    OSC_FAULT_SOURCES, /* more sources than there is room for */
    OSC_FAULT_KINDS
} osc_fault;

#endif
