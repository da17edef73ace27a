"""The withheld-data bench: an examination of gap diagnosers, written before there is anything to examine.

It makes campaigns with a known cause hidden in them, lets a diagnoser read them, and scores what the
diagnoser says.  It shares no line with the software that it examines: every formula here is written from
the contract's text a second time, so that a mistake made twice in the same way is unlikely.

    chain/        the measurement chain: motion, readings, electronics, link, noise, capture files
    effects/      the catalogue's effects, and effects that never were in the catalogue
    study/        protocol, cases, sealing
    clairvoyant/  what could be known at best: signal-to-noise ratios and separations
    score/        judging diagnoses against sealed labels
    report/       figures and the page
"""
