"""What is said to whoever a run has ended for, by whichever process ends it."""

#: Ends the sentence of a run that ends because its device is not there.
WAIT_ADVICE = "`limbd run --wait` waits for it"
