/* The names of the verdicts (verdict.h). */
#include "report/verdict.h"

const char *const claim_verdict_names[CLAIM_VERDICTS] = {[CLAIM_HOLDS] = "holds",
                                                         [CLAIM_ASSUMED] = "holds under stated assumption",
                                                         [CLAIM_IDENTITY] = "identity",
                                                         [CLAIM_FAILS] = "does not hold",
                                                         [CLAIM_UNDECIDED] = "cannot be decided"};
