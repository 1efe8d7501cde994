/* Delays of an image row as polynomials of the distance along the track: no root for each entry of the tables.

   Delay and sample of a pair are smooth in u, the distance of the ping ahead of the column (row.h). The row's range of
   u is cut into pieces, each with a polynomial of degree PIECE_POWERS - 1 through exact delays at its Chebyshev points.
   A piece is so short (piece_half) that the phase error stays within the limit in budget.h. */
#ifndef SASBENCH_BACKPROJECTION_INVARIANT_PIECES_H
#define SASBENCH_BACKPROJECTION_INVARIANT_PIECES_H

enum {
    PIECE_POWERS = 10, /* and exact delays of a piece */
    PIECES_MOST = 64   /* of a row: with more, each delay is evaluated */
};

/* From values at Chebyshev points of [-1, 1] to the coefficients of the polynomial through them. */
struct piece_fit {
    double node[PIECE_POWERS];
    double power[PIECE_POWERS][PIECE_POWERS]; /* [node][power], lowest first */
};
void piece_fit_make(struct piece_fit *fit);

/* The reach of pieces, m^(1/PIECE_POWERS). A piece may extend piece_half to either side of its middle if all distances
   from it to the pings are at least `distance` m. Its delays then err by at most `error` m of path. `mach`: the sonar's
   speed over the sound's, below 1/4. */
double piece_reach(double mach, double error);
double piece_half(double reach, double distance);

#endif
