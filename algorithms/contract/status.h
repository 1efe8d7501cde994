/* How a function reports failure: a status, and one message made where the fault was found. */
#ifndef SASBENCH_CONTRACT_STATUS_H
#define SASBENCH_CONTRACT_STATUS_H

enum status {
    STATUS_OK = 0,
    STATUS_FAILED = 1,     /* a run failed: out of memory, a file could not be written */
    STATUS_INVALID = 2,    /* bad usage or bad input: the message has the place, the value and the accepted values */
    STATUS_UNSUPPORTED = 3 /* legal input that this algorithm cannot image: the message is the reason */
};

/* Store the message (printf style, one line without newline, at most 1023 bytes) and return `status`, so that a callee
   can write `return status_set(STATUS_INVALID, "...")`. One message for each thread, overwritten by the next; a message
   of a worker of a parallel region reaches the thread that waits for it (of several the last one). */
enum status status_set(enum status status, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The calling thread's last message, or that of its workers since; never NULL, valid until its next status_set. */
const char *status_message(void);

#endif
